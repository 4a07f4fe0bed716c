// What modules use of a browser while they are loaded.
const nothing = () => undefined

globalThis.matchMedia ??= (() => ({ matches: false, addEventListener: nothing })) as never
globalThis.addEventListener ??= nothing
