// The texts of the guides, which come with the first guide or the first search, not with every page.
export const TEXTS = import.meta.glob<string>('../../../docs/*.md', { query: '?raw', import: 'default', eager: true })
