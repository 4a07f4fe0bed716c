// The path below which the service is found, such as /clearance behind a proxy; empty for the root of a host.
// The service writes it into the page, see `backend/http/pages.py`.

// Tests have no document, or a part of one.
const page = typeof document === 'undefined' ? undefined : (document as { documentElement?: { dataset?: DOMStringMap } })

export const ROOT = page?.documentElement?.dataset?.root ?? ''

/** A path of the service as a browser requests it. */
export const at = (path: string): string => ROOT + path

/** A path of an address without that prefix. */
export const inside = (path: string): string => (ROOT && path.startsWith(`${ROOT}/`) ? path.slice(ROOT.length) : path)
