// The imported files, as they were and to be deleted.
import { IconDownload } from '@tabler/icons-react'
import { useQuery } from '@tanstack/react-query'
import { clsx } from 'clsx'
import { useState } from 'react'
import { useChange } from '../api/change'
import { contentOf, importsQuery } from '../api/requirements'
import { deleteImport, type RequirementFileOut } from '../client'
import { count } from '../format/numbers'
import { when } from '../format/time'
import { Failed } from '../page/Trouble'
import { Button, ButtonAnchor } from '../ui/Button'
import { Form } from '../ui/Form'
import { Card } from '../ui/Card'
import { Digest } from '../ui/Digests'
import { Modal } from '../overlay/Modal'
import { buttonColumn, Table, timeColumn } from '../ui/Table'
import { layout } from '../ui/styles'
import styles from './requirements.module.css'

export function Files({ mayChange }: { mayChange: boolean }) {
  const { data, error, refetch } = useQuery(importsQuery)
  const [leaving, setLeaving] = useState<RequirementFileOut | null>(null)
  const remove = useChange((file: number) => deleteImport({ path: { file } }), ['requirements', 'requirement-files'], () => setLeaving(null))
  if (!data?.length && (data || !error)) return null
  return (
    <div style={{ marginTop: 'var(--gap)' }}>
      <Card title="Imported files" note={data && 'Downloaded byte for byte as they were imported'} flush={data !== undefined}>
        {data ? (
          <Table
            stack
            rows={data}
            by={({ id }) => id}
            columns={[
              { head: 'File', tone: clsx(layout.wrapAny, styles.named), cell: ({ name }) => name },
              { head: 'Requirements', num: true, label: 'Requirements', cell: ({ requirements }) => count(requirements) },
              timeColumn<RequirementFileOut>(
                'Imported',
                ({ imported }) => imported,
                ({ imported, imported_by }) => `${when(imported)}, by ${imported_by}`,
              ),
              { head: 'sha256', label: 'sha256', className: layout.hideS, cell: ({ digest }) => <Digest of={digest} /> },
              buttonColumn<RequirementFileOut>('Actions', (file) => (
                <span className={clsx(styles.fileActs, 'nw')}>
                  <ButtonAnchor small icon={IconDownload} href={contentOf(file)} download aria-label={`Download ${file.name}`} />
                  {mayChange && (
                    <Button small danger aria-label={`Delete ${file.name} …`} onClick={() => setLeaving(file)}>
                      Delete …
                    </Button>
                  )}
                </span>
              )),
            ]}
          />
        ) : (
          error && <Failed error={error} retry={() => void refetch()} />
        )}
      </Card>
      <Modal opened={leaving !== null} onClose={() => setLeaving(null)} title="Delete a file of requirements">
        {leaving && (
          <Form sent={remove} onSend={() => remove.mutate(leaving.id)} send="Delete the file" onLeave={() => setLeaving(null)} danger>
            <p>
              {leaving.name} and its {count(leaving.requirements)} requirements are deleted. Those that a run states stay in the matrix, as stated by
              campaigns only. The audit trail keeps the digest of the file, not the file.
            </p>
          </Form>
        )}
      </Modal>
    </div>
  )
}
