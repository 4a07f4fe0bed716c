// A button with a menu or a panel, which is loaded and mounted at its first use: a page has many, and most are never opened.
import { type ComponentProps, type ReactNode, useId, useRef, useState } from 'react'
import { Overlay } from './later'
import type { OverlayProps } from './parts'
import { Part } from '../page/later'

interface PopupProps extends Pick<OverlayProps, 'kind' | 'position' | 'width' | 'withinPortal' | 'dropdown'> {
  button: ComponentProps<'button'> & Record<`data-${string}`, unknown>
  /** Where the content needs to know or to decide whether it is open. */
  opened?: boolean
  onChange?: (opened: boolean) => void
  children: ReactNode
}

export function Popup({ kind, button, opened: controlled, onChange, position = 'bottom-end', children, ...more }: PopupProps) {
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
  const props = { kind, target, id, opened, onChange: change, position, ...more }
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
        onPointerEnter={() => void Overlay.preload()}
        onFocus={() => void Overlay.preload()}
        onClick={(event) => {
          button.onClick?.(event)
          change(!opened)
        }}
      />
      {used && (
        <Part>
          <Overlay {...props}>{children}</Overlay>
        </Part>
      )}
    </>
  )
}
