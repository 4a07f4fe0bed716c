// How this browser draws WebGL 2, which the 3D view requires. Asked once: a context costs milliseconds.
export type Graphics = 'none' | 'software' | 'hardware'

/** Renderers that draw on the processor: of Chromium, Mesa and Windows. */
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i

let known: Graphics | undefined

export function graphics(canvas = () => document.createElement('canvas')): Graphics {
  known ??= graphicsOf(canvas())
  return known
}

function graphicsOf(canvas: HTMLCanvasElement): Graphics {
  const context = canvas.getContext('webgl2')
  if (!context) return 'none'
  const unmasked = context.getExtension('WEBGL_debug_renderer_info')?.UNMASKED_RENDERER_WEBGL
  const renderer = String(context.getParameter(unmasked ?? context.RENDERER))
  // Browsers allow few contexts at a time; this one is given back.
  context.getExtension('WEBGL_lose_context')?.loseContext()
  return SOFTWARE.test(renderer) ? 'software' : 'hardware'
}
