// Starts the pages: styles first; then all that an address needs is asked for at once, code and data alike, instead of
// one after another.
import './theme/styles'
import { askAhead } from './api/ahead'
import { pageAt } from './app/lazy'

const pages = import('./app/Pages')
// Where its code does not come, the router asks again, and says so.
pageAt(location.pathname)?.().catch(() => undefined)
askAhead(location)
// Fonts would wait for the first words that need them, and lay all words out again when they come.
void document.fonts.load('1em "Inter Variable"')
void document.fonts.load('1em "JetBrains Mono Variable"')

const root = document.getElementById('root')
if (root) void pages.then(({ show }) => show(root))
