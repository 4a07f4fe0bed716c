// A dialog of Mantine that is mounted at its first use: a page has several, and most are never opened.
import { Modal as MantineModal, type ModalProps } from '@mantine/core'
import { useEffect, useState } from 'react'

export function Modal({ opened, ...props }: ModalProps) {
  const [used, setUsed] = useState(false)
  // Mounted closed and opened then, because the focus returns to what had it when a mounted dialog opened.
  useEffect(() => {
    if (opened) setUsed(true)
  }, [opened])
  return opened || used ? <MantineModal opened={opened && used} {...props} /> : null
}
