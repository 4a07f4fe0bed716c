// Whether this browser draws WebGL 2, which the 3D view requires. Asked once: a context costs milliseconds.
let known: boolean | undefined

export function drawable(canvas = () => document.createElement('canvas')): boolean {
  known ??= draws(canvas())
  return known
}

function draws(canvas: HTMLCanvasElement): boolean {
  const context = canvas.getContext('webgl2')
  // Browsers allow few contexts at a time; this one is given back.
  context?.getExtension('WEBGL_lose_context')?.loseContext()
  return context !== null
}
