// The number or the name of a run, which leads to its page.
import { Link } from '@tanstack/react-router'

export const RunLink = ({ run, children = run, ...rest }: { run: string; className?: string; title?: string; onClick?: () => void; children?: string }) => (
  <Link to="/runs/$id" params={{ id: run }} {...rest}>
    {children}
  </Link>
)
