// Keys of requests and of views.
import { useRef } from 'react'

/** Gives a request its key: the same for the same request, so that pressing twice never launches twice. */
export function useKey(): (request: unknown) => string {
  const last = useRef({ body: '', key: '' })
  return (request) => {
    const body = JSON.stringify(request)
    if (last.current.body !== body) last.current = { body, key: uuid() }
    return last.current.key
  }
}

/** A random UUID (RFC 9562, version 4). crypto.randomUUID() is missing where a page came by plain HTTP. */
export function uuid(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(16))
  bytes[6] = ((bytes[6] ?? 0) & 0x0f) | 0x40
  bytes[8] = ((bytes[8] ?? 0) & 0x3f) | 0x80
  const hex = Array.from(bytes, (byte) => byte.toString(16).padStart(2, '0')).join('')
  return hex.replace(/^(.{8})(.{4})(.{4})(.{4})(.{12})$/, '$1-$2-$3-$4-$5')
}
