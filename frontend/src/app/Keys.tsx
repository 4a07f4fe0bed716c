// The keyboard shortcuts of all pages, shown by `?`.
import { Modal } from '../overlay/Modal'
import { buttons, layout } from '../ui/styles'
import styles from './app.module.css'

const KEYS: { title: string; keys: [string[], string][] }[] = [
  {
    title: 'Everywhere',
    keys: [
      [['?'], 'Show these keys'],
      [['Ctrl', 'K'], 'Search everything and go there'],
      [['/'], 'Search runs'],
      [['n'], 'New run'],
    ],
  },
  {
    title: 'List of runs',
    keys: [
      [['j', 'k'], 'Next and previous run'],
      [['x'], 'Select the run'],
      [['Enter'], 'Open the run'],
      [['Esc'], 'Leave the search'],
    ],
  },
  {
    title: 'Page of a run',
    keys: [
      [['1', '…', '9'], 'Go to a section'],
      [['j', 'k'], 'Next and previous finding'],
    ],
  },
  {
    title: 'Flight of a run, while it has the focus',
    keys: [
      [['Space'], 'Play and pause'],
      [['←', '→'], '0.1 s back and forward'],
      [['Shift', '←', '→'], '1 s back and forward'],
      [['Home'], 'Closest approach'],
      [['Esc'], 'Leave the full screen'],
    ],
  },
  {
    title: 'What-if, on a slider',
    keys: [
      [['←', '→'], '1/400 of the range'],
      [['PgUp', 'PgDn'], '1/20 of the range'],
      [['Home', 'End'], 'Lower and upper bound'],
    ],
  },
  {
    title: 'Launch',
    keys: [
      [['1', '…', '7'], 'Go to a section'],
      [['Ctrl', 'Enter'], 'Start the run'],
    ],
  },
]

export function Keys({ opened, onClose }: { opened: boolean; onClose: () => void }) {
  return (
    <Modal opened={opened} onClose={onClose} title="Keys" size={620}>
      <div className={styles.keys}>
        {KEYS.map(({ title, keys }) => (
          <section key={title}>
            <h3>{title}</h3>
            <dl>
              {keys.map(([caps, text]) => (
                <div key={text} className={layout.row}>
                  <dt className={layout.row}>
                    {caps.map((cap) => (cap === '…' ? ' … ' : <kbd key={cap} className={buttons.kbd}>{cap}</kbd>))}
                  </dt>
                  <dd>{text}</dd>
                </div>
              ))}
            </dl>
          </section>
        ))}
      </div>
    </Modal>
  )
}
