// Text of the service or of a docstring: what is between backticks is code.

export const Ticked = ({ text = '' }: { text?: string }) => text.split('`').map((part, i) => (i % 2 ? <code key={i}>{part}</code> : part))
