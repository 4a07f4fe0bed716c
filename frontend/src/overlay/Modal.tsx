// A dialog that is loaded and mounted at its first use: a page has several, and most are never opened.
import type { ModalProps } from '@mantine/core'
import { useState } from 'react'
import { Dialog } from './later'
import { Part } from '../page/later'

export function Modal(props: ModalProps) {
  const [used, setUsed] = useState(props.opened)
  if (props.opened && !used) setUsed(true)
  return used ? (
    <Part>
      <Dialog {...props} />
    </Part>
  ) : null
}
