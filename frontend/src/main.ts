// Starts the pages: styles first; then code and data for the address are requested in parallel.
import './theme/styles'
import { askAhead } from './api/ahead'
import { pageAt } from './app/lazy'

const pages = import('./app/Pages')
// If the code cannot be loaded, its page says so.
pageAt(location.pathname)?.().catch(() => undefined)
askAhead(location)
// Without preloading, fonts would be requested at first use and cause a second layout.
// Greek symbols are in a separate font file.
void document.fonts.load('1em "Inter Variable"', 'aα')
void document.fonts.load('1em "JetBrains Mono Variable"')

const root = document.getElementById('root')
if (root) void pages.then(({ show }) => show(root))
