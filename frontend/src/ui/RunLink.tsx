// The number of a run, which leads to its page.
import { Link } from '@tanstack/react-router'

export const RunLink = ({ run, ...rest }: { run: string; className?: string; onClick?: () => void }) => (
  <Link to="/runs/$id" params={{ id: run }} {...rest}>
    {run}
  </Link>
)
