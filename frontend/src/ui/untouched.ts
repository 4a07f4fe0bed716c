// Whether a page has only been read since it was loaded: then what is far from the window is not laid out, see `.later` in
// layout.module.css. The first key, press or link ends that, so that jumps go to where everything is.

const ENDS = ['pointerdown', 'keydown', 'focusin', 'hashchange', 'popstate'] as const

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
