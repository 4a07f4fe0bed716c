// Letters typed between Ctrl K and the moment the search field has the focus: the dialog may have to be loaded first.

/** Time after which the page gets its keys back, should the dialog never come [ms]. */
const LONGEST = 5000

let typed: string | null = null
let timer: ReturnType<typeof setTimeout> | undefined

/** Keep what is typed from now on, so that no letter is lost or taken for a key of the page. */
export function keepTyped(): void {
  if (typed !== null) return
  typed = ''
  document.addEventListener('keydown', keep, true)
  timer = setTimeout(typedEarly, LONGEST)
}

/** What was typed since; the page has its keys again. */
export function typedEarly(): string {
  const found = typed ?? ''
  typed = null
  clearTimeout(timer)
  document.removeEventListener('keydown', keep, true)
  return found
}

function keep(event: KeyboardEvent): void {
  if (event.ctrlKey || event.altKey || event.metaKey || typed === null) return
  if (event.key.length === 1) typed += event.key
  else if (event.key === 'Backspace') typed = typed.slice(0, -1)
  else if (event.key !== 'Enter') return
  event.preventDefault()
  event.stopPropagation()
}
