// Whether a page has only been read since it was loaded: then what is far from the window is not laid out, see `.later` in
// layout.module.css. The first key, press, link, print or other size of the window ends that: jumps go to where everything
// is, and charts have their size.

const ENDS = ['pointerdown', 'keydown', 'focusin', 'hashchange', 'popstate', 'resize', 'beforeprint'] as const

/** Called once, before anything is shown. A page that opens elsewhere than at its top is laid out as a whole. */
export function beginUntouched(): void {
  const [opened] = performance.getEntriesByType('navigation') as PerformanceNavigationTiming[]
  if (location.hash || opened?.type !== 'navigate') return
  const { dataset } = document.documentElement
  const ended = () => {
    delete dataset.untouched
    for (const kind of ENDS) removeEventListener(kind, ended, { capture: true })
  }
  dataset.untouched = ''
  for (const kind of ENDS) addEventListener(kind, ended, { capture: true, passive: true })
}
