// Rendering of notes: common Markdown, and no active content.
import { renderToStaticMarkup } from 'react-dom/server'
import { expect, it } from 'vitest'
import { isSafe, Markdown } from './Markdown'

const shown = (text: string): string => renderToStaticMarkup(<Markdown text={text} />).replace(/^<div class="[^"]*">|<\/div>$/g, '')

it.each([
  ['# Why\n\nThe *radius* is **75 m**.', '<h3>Why</h3><p>The <em>radius</em> is <strong>75 m</strong>.</p>'],
  ['- a\n- b `c`', '<ul><li>a</li><li>b <code>c</code></li></ul>'],
  ['3. c\n4. d', '<ol start="3"><li>c</li><li>d</li></ol>'],
  ['> said\n\n---', '<blockquote><p>said</p></blockquote><hr/>'],
  ['```\na < b\n```', '<pre tabindex="0"><code>a &lt; b</code></pre>'],
  ['see [R-1](/runs/R-0001)', '<p>see <a href="/runs/R-0001" rel="noreferrer">R-1</a></p>'],
  ['~~old~~ a\\*b &amp; c', '<p><del>old</del> a*b &amp; c</p>'],
])('shows %j', (text, html) => {
  expect(shown(text)).toBe(html)
})

it('shows a table', () => {
  expect(shown('| a | b |\n|---|--:|\n| 1 | 2 |')).toContain('<td style="text-align:right">2</td>')
})

it.each([
  '<script>alert(1)</script>',
  '<img src=x onerror=alert(1)>',
  'text <b onclick="x()">bold</b>',
  '[x](javascript:alert(1))',
  '[x](data:text/html,x)',
  '[x](//evil.example)',
  '![picture](https://evil.example/x.png)',
  '<https://evil.example/"onmouseover=x>',
  '[x]( java\nscript:x)',
])('lets %j do nothing', (text) => {
  const html = shown(text)
  expect(html).not.toMatch(/<(script|img|b|iframe)|<[^>]*\son\w+=|href="(javascript|data|\/\/)/i)
})

it('takes addresses of the web and of the service only', () => {
  expect(['https://a.example', 'HTTP://a', 'mailto:a@b', '/runs', '#x'].every(isSafe)).toBe(true)
  expect(['javascript:x', ' javascript:x', 'data:x', '//a', 'vbscript:x', 'runs'].some(isSafe)).toBe(false)
})
