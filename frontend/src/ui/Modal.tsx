// A dialog of Mantine that is mounted at its first use: a page has several, and most are never opened.
import { Modal as MantineModal, type ModalProps } from '@mantine/core'
import { useDeferredValue, useState } from 'react'

export function Modal({ opened, ...props }: ModalProps) {
  const [used, setUsed] = useState(opened)
  if (opened && !used) setUsed(true)
  // Mounted closed and opened then, because the focus returns to what had it when a mounted dialog opened.
  const mounted = useDeferredValue(opened, false)
  // Mantine locks scrolling by a style element, which the security policy could refuse.
  return used ? <MantineModal opened={opened && mounted} centered lockScroll={false} {...props} /> : null
}
