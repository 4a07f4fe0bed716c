// Users as the pages name them: what an API token did belongs to its user, with the name of the token.

/** ada (token ci) */
export const launchedBy = ({ owner, token }: { owner: string; token: string | null }): string => (token ? `${owner} (token ${token})` : owner)

const VIA: Readonly<Record<string, string>> = { link: 'by login link', provider: 'by single sign-on', cli: 'by command line' }

/** How a user of an entry of the audit trail was authenticated. */
export const viaOf = ({ user, via }: { user: string; via: string }): string => (via === 'token' ? `by token ${user}` : (VIA[via] ?? `by ${via}`))
