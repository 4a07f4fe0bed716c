// Ticks, ranges, merging of curves, and files.
import { describe, expect, it } from 'vitest'
import { toCsv } from './csv'
import { alone, linesOn, stepsOn, union } from './series'
import { isFar } from './reach'
import { labelWidth, linearTicks, logTicks, padded, tickDecimals, tickText } from './ticks'

describe('ticks', () => {
  it('are round and within the range', () => {
    expect(linearTicks(0, 15, 5)).toEqual([0, 5, 10, 15])
    expect(linearTicks(0.9417, 0.9436, 4)).toEqual([0.942, 0.9425, 0.943, 0.9435])
    expect(linearTicks(-2, 2, 4)).toEqual([-2, -1, 0, 1, 2])
  })
  it('are powers of ten on a logarithmic axis', () => {
    expect(logTicks(1, 2000)).toEqual([1, 10, 100, 1000])
    expect(logTicks(1, 30)).toEqual([1, 2, 5, 10, 20])
  })
  it('are distinguished by their decimals', () => {
    expect(tickDecimals([0.942, 0.9425, 0.943])).toBe(4)
    expect(tickDecimals([0, 2.5, 5])).toBe(1)
    expect(tickDecimals([0, 10, 20])).toBe(0)
  })
  it.each<[number[], string[]]>([
    [[0, 2.5, 5], ['0.0', '2.5', '5.0']],
    [[-20, 0, 20], ['−20', '0', '20']],
    [[0, 100_000, 200_000], ['0', '100\u202f000', '200\u202f000']],
    [[0, 5e11, 1e12, 1.5e12], ['0', '5e11', '1e12', '1.5e12']],
    [[-1e12, 0, 1e12], ['−1e12', '0', '1e12']],
    [[1.0025e12, 1.005e12], ['1.0025e12', '1.005e12']],
    [[0, 2e-11, 4e-11], ['0', '2e−11', '4e−11']],
    [[999_999_999_998, 999_999_999_999], ['999\u202f999\u202f999\u202f998', '999\u202f999\u202f999\u202f999']],
    [[3e15], ['3e15']],
  ])('%j are labelled %j', (ticks, labels) => {
    const text = ticks.map(tickText(ticks))
    expect(text).toEqual(labels)
    expect(new Set(text).size).toBe(ticks.length)
  })
  it('of any size need at most 62 px', () => {
    for (let power = -15; power <= 300; power += 1)
      for (const ticks of [linearTicks(-(10 ** power), 10 ** power, 3), linearTicks(0, 3.1 * 10 ** power, 3)])
        for (const label of ticks.map(tickText(ticks))) expect(labelWidth(label), label).toBeLessThanOrEqual(62)
  })
  it('lie in a range that is never empty', () => {
    expect(padded([5, 5])[0]).toBeLessThan(5)
    expect(padded([])).toEqual([0, 1])
  })
})

describe('curves on common abscissae', () => {
  const a = { x: [1, 5, 9], y: [10, 8, 7] }
  const b = { x: [2, 4], y: [9, 6] }
  it('union', () => expect(union([a, b])).toEqual([1, 2, 4, 5, 9]))
  it('steps hold and end', () => {
    expect(stepsOn([1, 2, 4, 5, 9], a)).toEqual([10, 10, 10, 8, 7])
    expect(stepsOn([1, 2, 4, 5, 9], b)).toEqual([null, 9, 6, null, null])
  })
  it.each([
    [[1.2, null, 0.2, 1.1, 1.3]],
    [[null, 0.3, null]],
    [[0.3, null, null, 1]],
    [[1, 2, 3]],
    [[null]],
    [[0.1]],
  ])('values next to missing ones are retained: %j', (y) => {
    const x = y.map((_, k) => 0.5 * k)
    expect(linesOn(x, { x, y })).toEqual(y)
    const finer = union([{ x, y }, { x: x.map((at) => at + 0.25), y }])
    const found = linesOn(finer, { x, y })
    expect(x.map((at) => found[finer.indexOf(at)])).toEqual(y)
  })
  it('values without a neighbour are points', () => {
    expect(alone([1.2, null, 0.2, 1.1, null, 3])).toEqual([0, 5])
    expect(alone([null, 2, 3, null, undefined, 4, undefined])).toEqual([5])
    expect(alone([1])).toEqual([0])
  })
  it('lines interpolate', () => expect(linesOn([0, 1, 3, 9, 10], a)).toEqual([null, 10, 9, 7, null]))
})

it('CSV quotes what needs it and keeps every digit', () => {
  const table = {
    name: 't',
    columns: ['a, b', 'c'],
    rows: [
      ['say "x"', 0.1 + 0.2],
      [null, -1],
    ],
  }
  expect(toCsv(table)).toBe('"a, b",c\r\n"say ""x""",0.30000000000000004\r\n,-1\r\n')
})

it('CSV marks text that a spreadsheet would calculate, and no number', () => {
  const table = { name: 't', columns: ['=1+1', 'c'], rows: [['@x', -1]] }
  expect(toCsv(table)).toBe("'=1+1,c\r\n'@x,-1\r\n")
})

describe('isFar', () => {
  it('detects a criterion that would flatten the values, below or above them', () => {
    const values = [10, 11, 12]
    expect([-2.1, -2, 9, 24, 24.1].map((value) => isFar(values, value))).toEqual([true, false, false, false, true])
    expect(isFar([], 5)).toBe(false)
  })
})
