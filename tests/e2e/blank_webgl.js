// WebGL 2 without a picture: every call is accepted, nothing is compiled or drawn. `blankDraws` counts the draw calls.
(() => {
  const GL = WebGL2RenderingContext
  const LIMIT = 4096 // of every size and number that is asked for, where nothing else is stated
  const PARAMETERS = {
    [GL.VERSION]: 'WebGL 2.0 (blank)',
    [GL.SHADING_LANGUAGE_VERSION]: 'WebGL GLSL ES 3.00 (blank)',
    [GL.RENDERER]: 'blank',
    [GL.VENDOR]: 'blank',
    [GL.COMPRESSED_TEXTURE_FORMATS]: [],
  }
  const PROGRAM = { [GL.LINK_STATUS]: true, [GL.ACTIVE_UNIFORMS]: 0, [GL.ACTIVE_ATTRIBUTES]: 0 }
  const draw = () => void (window.blankDraws += 1)
  const methods = (canvas) => ({
    getParameter: (name) => [GL.VIEWPORT, GL.SCISSOR_BOX].includes(name)
      ? new Int32Array([0, 0, canvas.width, canvas.height])
      : PARAMETERS[name] ?? LIMIT,
    getContextAttributes: () => ({ alpha: true, antialias: true, depth: true, premultipliedAlpha: true, stencil: false }),
    getShaderPrecisionFormat: () => ({ precision: 23, rangeMin: 127, rangeMax: 127 }),
    getSupportedExtensions: () => [],
    getExtension: (name) => (name.startsWith('EXT_color_buffer') ? {} : null),
    getError: () => GL.NO_ERROR,
    isContextLost: () => false,
    checkFramebufferStatus: () => GL.FRAMEBUFFER_COMPLETE,
    clientWaitSync: () => GL.ALREADY_SIGNALED,
    getShaderParameter: () => true,
    getProgramParameter: (_, name) => PROGRAM[name] ?? true,
    getShaderInfoLog: () => '',
    getProgramInfoLog: () => '',
    getAttribLocation: () => -1,
    getUniformLocation: () => null,
    drawArrays: draw,
    drawElements: draw,
    drawArraysInstanced: draw,
    drawElementsInstanced: draw,
  })

  function blank(canvas) {
    const known = { ...methods(canvas), canvas, drawingBufferColorSpace: 'srgb', unpackColorSpace: 'srgb' }
    return new Proxy(Object.create(GL.prototype), {
      get: (_, name) => {
        if (name in known) return known[name]
        if (name === 'drawingBufferWidth') return canvas.width
        if (name === 'drawingBufferHeight') return canvas.height
        if (typeof name !== 'string') return undefined
        if (name in GL) return GL[name]
        if (name.startsWith('create') || name === 'fenceSync') return () => ({})
        return () => undefined
      },
      set: () => true,
    })
  }

  window.blankDraws = 0
  const contexts = new WeakMap()
  const real = HTMLCanvasElement.prototype.getContext
  HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
    if (kind !== 'webgl2') return real.call(this, kind, ...rest)
    if (!contexts.has(this)) contexts.set(this, blank(this))
    return contexts.get(this)
  }
})()
