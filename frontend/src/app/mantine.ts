// The theme of Mantine; its styles are in theme/styles.ts, the look itself in theme/mantine.css.
import { createTheme } from '@mantine/core'

export const mantineTheme = createTheme({
  fontFamily: '"Inter Variable", system-ui, sans-serif',
  defaultRadius: 6,
  cursorType: 'pointer',
  respectReducedMotion: true,
  // The menu itself takes the focus: a hidden focus target in it would be an invalid child of a menu.
  components: {
    Menu: { defaultProps: { withInitialFocusPlaceholder: false } },
    Modal: { defaultProps: { closeButtonProps: { 'aria-label': 'Close' } } },
  },
})
