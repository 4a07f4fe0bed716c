// States that two runs of one campaign were run by different code, and names the source files that differ where stored.
import { useQuery } from '@tanstack/react-query'
import { codeQuery } from '../api/queries'
import type { RunDetail } from '../client'
import { otherCode, otherCodeText } from './code'

interface OtherCodeProps {
  runs: readonly RunDetail[]
  className?: string
  /** A further sentence. */
  more?: string
}

export function OtherCode({ runs, className, more = '' }: OtherCodeProps) {
  const pair = otherCode(runs)
  const [a, b] = pair ?? []
  const { data, isPending } = useQuery({ ...codeQuery(b?.id ?? '', a?.id ?? ''), enabled: pair !== null })
  if (!a || !b || isPending) return null
  return (
    <p className={className} data-testid="other-code">
      {otherCodeText(a, b, data?.files)}
      {more}
    </p>
  )
}
