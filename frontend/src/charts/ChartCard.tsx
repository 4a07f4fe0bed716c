// A card around a chart: legend in the heading, the numbers as a table or a CSV file one click away.
import { clsx } from 'clsx'
import { IconDownload, IconPhoto, IconTable } from '@tabler/icons-react'
import { type MouseEvent, type ReactNode, useState } from 'react'
import { plain } from '../format/numbers'
import { MenuItem } from '../overlay/later'
import { Card } from '../ui/Card'
import { IconButton } from '../ui/IconButton'
import { Popup } from '../overlay/Popup'
import { save } from '../ui/files'
import { Table } from '../ui/Table'
import { type DataTable, toCsv, type Value } from './csv'
import { isDrawing, savePng, saveSvg } from './figure'
import { buttons as buttonsCss, layout } from '../ui/styles'
import styles from './charts.module.css'

const MOST_ROWS = 400

interface ChartCardProps {
  title: ReactNode
  note?: ReactNode
  right?: ReactNode
  footer?: ReactNode
  className?: string
  id?: string
  /** Created on demand. */
  data: () => DataTable
  run: string
  children: ReactNode
}

export function ChartCard({ data, run, right, children, footer, ...card }: ChartCardProps) {
  const [open, setOpen] = useState(false)
  const download = () => {
    const made = data()
    save(`${run}-${made.name}.csv`, toCsv(made), 'text/csv')
  }
  const buttons = (
    <>
      {right}
      <span className={layout.row} style={{ gap: 4 }}>
        <IconButton label={open ? 'Hide data' : 'Show data'} icon={IconTable} pressed={open} act={() => setOpen(!open)} />
        <FigureButton name={() => `${run}-${data().name}`} />
        <IconButton label="Download CSV" icon={IconDownload} act={download} />
      </span>
    </>
  )
  return (
    <Card {...card} right={buttons} footer={open ? undefined : footer}>
      {children}
      {open && <Rows table={data()} />}
    </Card>
  )
}

/** Saves the chart as an image; as SVG too if it is drawn as SVG. */
function FigureButton({ name }: { name: () => string }) {
  const [card, setCard] = useState<HTMLElement | null>(null)
  const found = (event: MouseEvent<HTMLElement>) => setCard(event.currentTarget.closest<HTMLElement>('section'))
  return (
    <Popup
      kind="menu"
      width={150}
      button={{
        className: clsx(buttonsCss.iconbtn, buttonsCss.bd),
        'aria-label': 'Save figure',
        title: 'Save figure',
        'data-control': true,
        onClick: found,
        children: <IconPhoto className="i s" aria-hidden />,
      }}
    >
      <MenuItem onClick={() => card && void savePng(card, name())}>PNG image</MenuItem>
      {card && isDrawing(card) && <MenuItem onClick={() => saveSvg(card, name())}>SVG drawing</MenuItem>}
    </Popup>
  )
}

function Rows({ table }: { table: DataTable }) {
  const rows = table.rows.slice(0, MOST_ROWS)
  return (
    <>
      {table.rows.length > MOST_ROWS && (
        <p className="small mut">
          The first {MOST_ROWS} of {table.rows.length} rows; the CSV file has all of them.
        </p>
      )}
      <div data-control className={styles.datagrid} tabIndex={0} role="region" aria-label="Data of the chart">
        <Table
          rows={rows}
          columns={table.columns.map((head, k) => ({
            head,
            num: true,
            cell: (row: Value[]) => (typeof row[k] === 'number' ? plain(row[k], 8) : (row[k] ?? '')),
          }))}
        />
      </div>
    </>
  )
}
