// The theme of Mantine; its styles are in theme/styles.ts, the look itself in theme/mantine.css.
import { createTheme } from '@mantine/core'

export const mantineTheme = createTheme({
  fontFamily: '"Inter Variable", system-ui, sans-serif',
  defaultRadius: 6,
  cursorType: 'pointer',
  respectReducedMotion: true,
  // The menu itself takes the focus when it opens: a hidden element in it would be a child that no menu may have.
  components: {
    Menu: { defaultProps: { withInitialFocusPlaceholder: false } },
    Modal: { defaultProps: { closeButtonProps: { 'aria-label': 'Close' } } },
  },
})
