// The guides in the folder `docs` by name and title, in index order. A test compares them with the files.

export const GUIDES = [
  { name: 'index', title: 'Guides' },
  { name: 'first-campaign', title: 'A first campaign' },
  { name: 'your-own-component', title: 'Your own component' },
  { name: 'your-own-simulator', title: 'Your own simulator' },
  { name: 'python', title: 'From Python and notebooks' },
  { name: 'client', title: 'Python client of a service' },
  { name: 'recipes-px4-nav2', title: 'Recipes: PX4 and Nav2' },
  { name: 'cluster', title: 'Cluster' },
  { name: 'methods', title: 'Methods' },
  { name: 'scoreboard', title: 'Score board' },
  { name: 'evidence', title: 'Evidence' },
  { name: 'requirements', title: 'Requirements' },
  { name: 'ci', title: 'Continuous integration' },
  { name: 'access', title: 'Users and access' },
  { name: 'operation', title: 'Operation' },
  { name: 'architecture', title: 'Architecture' },
] as const

/** A guide's text without its title and comments, with links between guides as addresses of these pages. */
export function shown(text: string): string {
  return text.replace(/^# .*\n/, '').replaceAll(/<!--.*-->\n/g, '').replace(/\]\(([\w-]+)\.md(#[\w-]+)?\)/g, '](/help/guides/$1$2)')
}

/** Splits a text at its images; an image is its alternative text and file name. */
export function parts(text: string): (string | { alt: string; file: string })[] {
  return text.split(/^(!\[[^\]]*\]\(images\/[\w.-]+\))$/m).map((part) => {
    const picture = /^!\[([^\]]*)\]\(images\/([\w.-]+)\)$/.exec(part)
    return picture ? { alt: picture[1] ?? '', file: picture[2] ?? '' } : part
  })
}

/** The fragment of a heading, as in the links between the guides: "What a search does" is `what-a-search-does`. */
export const fragmentOf = (heading: string): string =>
  heading.toLowerCase().replace(/[^\p{L}\p{N} _-]/gu, '').trim().replaceAll(' ', '-')

/** The sections of a guide, for the list of contents; one of fewer than three needs none. */
export function sectionsOf(text: string): { title: string; entries: { id: string; name: string }[] }[] {
  const found = [...text.replace(/^```[\s\S]*?^```/gm, '').matchAll(/^## (.+)$/gm)].map(([, heading = '']) => ({
    id: fragmentOf(heading),
    name: heading.replaceAll('`', ''),
  }))
  return found.length < 3 ? [] : [{ title: 'In this guide', entries: found }]
}
