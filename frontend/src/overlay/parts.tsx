// The parts of Mantine that open over a page. Pages use them by `later.ts`, so that this code is loaded when one is opened.
import { Menu, Modal, type ModalProps, Popover, type PopoverDropdownProps, type PopoverProps } from '@mantine/core'
import { type ReactNode, type Ref, type RefObject, useDeferredValue, useImperativeHandle } from 'react'
import { Themed } from './Themed'
import { useReturnFocus } from './useReturnFocus'

export interface OverlayProps extends Pick<PopoverProps, 'id' | 'opened' | 'onChange' | 'position' | 'width' | 'withinPortal'> {
  kind: 'menu' | 'dialog'
  /** The button, which was on the page before. */
  target: RefObject<HTMLButtonElement | null>
  /** Of the dropdown. */
  dropdown?: Pick<PopoverDropdownProps, 'aria-label' | 'className'> & { ref?: Ref<HTMLDivElement> }
  children: ReactNode
}

// A popup is mounted closed and opened then, because the focus returns to what had it when a mounted one opened.

export function Overlay({ kind, target, opened, dropdown, children, ...props }: OverlayProps) {
  const shown = useDeferredValue(opened, false)
  const given = { opened: opened && shown, ...props }
  return (
    <Themed>
      {kind === 'menu' ? (
        <Menu {...given}>
          <Menu.Target>
            <Anchor of={target} />
          </Menu.Target>
          <Menu.Dropdown {...dropdown}>{children}</Menu.Dropdown>
        </Menu>
      ) : (
        <Popover {...given} trapFocus returnFocus shadow="none">
          <Popover.Target>
            <Anchor of={target} />
          </Popover.Target>
          <Popover.Dropdown {...dropdown}>{children}</Popover.Dropdown>
        </Popover>
      )}
    </Themed>
  )
}

/** Stands for the button. */
function Anchor({ of, ref }: { of: RefObject<HTMLButtonElement | null>; ref?: Ref<HTMLButtonElement> }) {
  useImperativeHandle(ref, () => of.current as HTMLButtonElement, [of])
  return null
}

export function Dialog(props: ModalProps) {
  useReturnFocus(props.opened)
  return (
    <Themed>
      {/* Mantine locks scrolling by a style element, which the security policy could refuse. */}
      <Modal centered lockScroll={false} returnFocus={false} {...props} />
    </Themed>
  )
}

export const MenuItem = Menu.Item
export const MenuLabel = Menu.Label
export const MenuDivider = Menu.Divider
