import { beforeEach, expect, test, vi } from 'vitest'

beforeEach(() => vi.resetModules())

const loseContext = vi.fn()
const canvas = (context: unknown) => ({ getContext: () => context }) as unknown as HTMLCanvasElement
const drawnBy = (masked: string, unmasked?: string) =>
  canvas({
    RENDERER: 1,
    getParameter: (name: number) => (name === 1 ? masked : unmasked),
    getExtension: (name: string) => {
      if (name === 'WEBGL_lose_context') return { loseContext }
      return unmasked === undefined ? null : { UNMASKED_RENDERER_WEBGL: 2 }
    },
  })

test.each([
  ['hardware', 'WebKit WebGL', 'ANGLE (NVIDIA, NVIDIA GeForce RTX 4070 (0x2786) Direct3D11 vs_5_0 ps_5_0, D3D11)'],
  ['software', 'WebKit WebGL', 'ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero) (0x0000C0DE)), SwiftShader driver)'],
  ['software', 'WebKit WebGL', 'ANGLE (Microsoft, Microsoft Basic Render Driver (0x008C) Direct3D11 vs_5_0 ps_5_0, D3D11)'],
  ['software', 'llvmpipe, or similar', undefined],
  ['hardware', 'Apple GPU', undefined],
])('%s: %s, %s; the context is given back', async (kind, masked, unmasked) => {
  const { graphics } = await import('./drawable')
  loseContext.mockClear()
  expect(graphics(() => drawnBy(masked, unmasked))).toBe(kind)
  expect(loseContext).toHaveBeenCalledOnce()
})

test('a browser without WebGL 2 draws nothing, and is asked once', async () => {
  const { graphics } = await import('./drawable')
  expect(graphics(() => canvas(null))).toBe('none')
  expect(graphics(() => drawnBy('Apple GPU'))).toBe('none')
})
