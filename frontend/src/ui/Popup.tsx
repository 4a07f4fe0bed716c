// A button with a Mantine menu or popover, which is mounted at its first use: a page has many, and most are never opened.
import { Menu, Popover, type PopoverProps } from '@mantine/core'
import { type ComponentProps, type ReactNode, type Ref, type RefObject, useDeferredValue, useId, useImperativeHandle, useRef, useState } from 'react'

interface PopupProps extends Pick<PopoverProps, 'position' | 'width' | 'withinPortal'> {
  kind: 'menu' | 'dialog'
  button: ComponentProps<'button'> & Record<`data-${string}`, unknown>
  /** Where the content needs to know or to decide whether it is open. */
  opened?: boolean
  onChange?: (opened: boolean) => void
  /** The dropdown. */
  children: ReactNode
}

export function Popup({ kind, button, opened: controlled, onChange, children, ...place }: PopupProps) {
  const id = useId()
  const target = useRef<HTMLButtonElement>(null)
  const [own, setOwn] = useState(false)
  const opened = controlled ?? own
  const [used, setUsed] = useState(opened)
  if (opened && !used) setUsed(true)
  const change = (next: boolean) => {
    setOwn(next)
    onChange?.(next)
  }
  // Mounted closed and opened then, because the focus returns to what had it when a mounted popover opened.
  const mounted = useDeferredValue(opened, false)
  const props = { id, opened: opened && mounted, onChange: change, ...place }
  return (
    <>
      <button
        type="button"
        {...button}
        ref={target}
        id={id}
        aria-haspopup={kind}
        aria-expanded={opened}
        aria-controls={opened ? `${id}-dropdown` : undefined}
        onClick={(event) => {
          button.onClick?.(event)
          change(!opened)
        }}
      />
      {used &&
        (kind === 'menu' ? (
          <Menu {...props}>
            <Menu.Target>
              <Anchor of={target} />
            </Menu.Target>
            {children}
          </Menu>
        ) : (
          <Popover {...props} trapFocus returnFocus shadow="none">
            <Popover.Target>
              <Anchor of={target} />
            </Popover.Target>
            {children}
          </Popover>
        ))}
    </>
  )
}

/** Stands for the button, which was on the page before. */
function Anchor({ of, ref }: { of: RefObject<HTMLButtonElement | null>; ref?: Ref<HTMLButtonElement> }) {
  useImperativeHandle(ref, () => of.current as HTMLButtonElement, [of])
  return null
}
