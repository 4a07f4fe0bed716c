// A column of a table for each uncertain parameter, headed by its symbol and unit.
import type { ReactNode } from 'react'
import { unitText } from '../../format/units'
import { Sign } from '../../ui/Sign'
import type { Column } from '../../ui/Table'
import type { UncertainParameter } from '../data/data'

export function parameterColumns<T>(
  parameters: readonly UncertainParameter[],
  cell: (row: T, parameter: UncertainParameter) => ReactNode,
  title?: 'text' | 'path',
  tone?: string,
): Column<T>[] {
  return parameters.map((p) => ({
    head: <Sign text={p.symbol} path={p.path} />,
    unit: unitText(p.unit),
    title: title && p[title],
    tone,
    cell: (row) => cell(row, p),
  }))
}
