// All reports: one for every run that has ended, with verdict, sign-offs, digest and files.
import { clsx } from 'clsx'
import { IconFileText, IconFileTypePdf } from '@tabler/icons-react'
import { useInfiniteQuery, useMutation } from '@tanstack/react-query'
import { Link, useNavigate, useSearch } from '@tanstack/react-router'
import { getFile } from '../api/calls'
import { paged } from '../api/queries'
import { listReports, type Report, type ReportFile } from '../client'
import { count } from '../format/numbers'
import { when } from '../format/time'
import { PageHead } from '../page/PageHead'
import { Unloaded } from '../page/Trouble'
import { useTitle } from '../page/useTitle'
import { SignedBy } from '../signoffs/SignedBy'
import { RunCell } from '../trends/cells'
import { Button, ButtonAnchor, TextButton } from '../ui/Button'
import { ShowMore } from '../ui/ShowMore'
import { Card } from '../ui/Card'
import { Digest } from '../ui/Digests'
import { Table, timeColumn } from '../ui/Table'
import { save } from '../ui/files'
import { SearchBox } from '../ui/SearchBox'
import { RunBadge } from '../ui/VerdictBadge'
import { layout } from '../ui/styles'
import styles from './reports.module.css'

// Sign-offs and new runs must be visible when the page is opened again.
const reportsQuery = (q: string) => paged(['reports', q], (cursor) => listReports({ query: { q, ...(cursor ? { cursor } : {}) } }), 0)

export function ReportsPage() {
  useTitle('Reports')
  const { q = '' } = useSearch({ from: '/reports' })
  const navigate = useNavigate({ from: '/reports' })
  const search = (text: string) => void navigate({ search: { q: text || undefined }, replace: true })
  const query = useInfiniteQuery(reportsQuery(q))
  if (!query.data)
    return (
      <>
        <PageHead title="Reports" />
        <Unloaded query={query} what="reports" below />
      </>
    )
  const items = query.data.pages.flatMap((page) => page.items)
  const { total = items.length, note = '' } = query.data.pages[0] ?? {}
  return (
    <>
      <PageHead title="Reports" />
      {(total > 0 || q) && (
        <div className={layout.filters}>
          <SearchBox label="Search reports" value={q} onChange={search} />
          <span className="small mut" aria-live="polite">
            {count(total)} {total === 1 ? 'report' : 'reports'}
          </span>
        </div>
      )}
      {note && (
        <p className="sec" role="status">
          {note}
        </p>
      )}
      <Card
        title="Safety-case reports"
        note="One for every listed run that has ended, made from its stored results when it is opened"
        flush={items.length > 0}
        footer={query.hasNextPage && <ShowMore query={query} total={total} />}
      >
        {items.length === 0 && (
          <p className="sec">
            {q ? (
              <>
                No report matches.{' '}
                <TextButton onClick={() => search('')}>Clear the search</TextButton>
              </>
            ) : (
              <>
                No listed run has ended. See the <Link to="/runs">list of runs</Link>, or <Link to="/launch">launch one</Link>.
              </>
            )}
          </p>
        )}
        {items.length > 0 && <Reports items={items} />}
      </Card>
    </>
  )
}

function Reports({ items }: { items: readonly Report[] }) {
  return (
    <Table
      stack
      rows={items}
      by={({ run }) => run}
      columns={[
        { head: 'Verdict', cell: (report) => <RunBadge run={report} /> },
        { head: 'Run', cell: ({ run, name, campaign_name }) => <RunCell run={run} name={name} campaign={campaign_name} /> },
        { head: 'Report', label: 'Report', className: layout.hideN, tone: 'sec nw', cell: ({ id }) => id },
        { head: 'Sign-off', label: 'Sign-off', className: styles.signed, cell: ({ signoffs }) => (signoffs.length > 0 ? <SignedBy items={signoffs} /> : <span className="mut">none</span>) },
        timeColumn<Report>('Finished', ({ finished }) => finished, ({ finished }) => (finished === null ? 'not recorded' : when(finished))),
        { head: 'Results, sha256', label: 'Results', className: layout.hideS, cell: ({ digest }) => <Digest of={digest} /> },
        {
          head: 'Files',
          cell: (report) => (
            <span className={clsx(layout.row, 'nw')} style={{ gap: 6 }}>
              {report.files.map((file) =>
                file.format === 'html' ? (
                  <ButtonAnchor key={file.format} small icon={IconFileText} href={file.href} target="_blank" rel="noreferrer" aria-label={`HTML report of ${report.run}`}>
                    HTML
                  </ButtonAnchor>
                ) : (
                  <Pdf key={file.format} report={report} file={file} />
                ),
              )}
            </span>
          ),
        },
      ]}
    />
  )
}

/** Printed on request, which takes a few seconds and can fail. */
function Pdf({ report, file }: { report: Report; file: ReportFile }) {
  const print = useMutation({
    mutationFn: () => getFile(file.href),
    onSuccess: (blob) => save(`${report.id}.pdf`, blob),
  })
  return (
    <>
      <Button
        small
        icon={IconFileTypePdf}
        disabled={file.unavailable !== null || print.isPending}
        title={file.unavailable ?? 'Printed on request, a few seconds'}
        aria-label={`PDF report of ${report.run}`}
        onClick={() => print.mutate()}
      >
        {print.isPending ? 'Printing …' : 'PDF'}
      </Button>
      {print.isError && (
        <span className="small bad-t" role="alert">
          {print.error.message}
        </span>
      )}
    </>
  )
}
