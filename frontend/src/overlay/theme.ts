// The theme of Mantine; its styles are in theme/styles.ts, the look itself in theme/mantine.module.css.
import { createTheme } from '@mantine/core'
import { fields } from '../ui/styles'
import look from '../theme/mantine.module.css'

export const mantineTheme = createTheme({
  respectReducedMotion: true,
  components: {
    Input: { classNames: { input: look.input, section: look.section } },
    // Else every closed list has all its options on the page, and its position is computed while the page loads.
    Combobox: { defaultProps: { keepMounted: false } },
    TagsInput: {
      classNames: { label: fields.lbl, input: look.tags, inputField: look.tagsField },
      defaultProps: { size: 'xs', maxTags: 20, splitChars: [',', ' '] },
    },
    Pill: { classNames: { root: look.pill } },
    Popover: { classNames: { dropdown: look.dropdown } },
    Select: { classNames: { dropdown: look.dropdown, option: look.option } },
    // The menu itself takes the focus: a hidden focus target in it would be an invalid child of a menu.
    Menu: { classNames: { dropdown: look.dropdown, item: look.option }, defaultProps: { withInitialFocusPlaceholder: false } },
    Modal: {
      classNames: { content: look.content, header: look.header, title: look.title },
      defaultProps: { closeButtonProps: { 'aria-label': 'Close' } },
    },
  },
})
