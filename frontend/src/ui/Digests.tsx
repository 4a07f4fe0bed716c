// Text with digests as everywhere on the pages: their beginning, and all of it under the pointer.
const DIGEST = /\b([0-9a-f]{64})\b/

/** How many digits of a digest tell it from the others. */
const FIRST = 16

/** The beginning of a digest. */
export const Digest = ({ of, first = FIRST }: { of: string; first?: number }) => (
  <span className="mono" title={of}>
    {of.slice(0, first)}
  </span>
)

export function Digests({ text }: { text: string }) {
  return text.split(DIGEST).map((part, i) =>
    i % 2 === 0 ? (
      part
    ) : (
      <Digest key={i} of={part} />
    ),
  )
}
