// The heading of a page that has nothing beside it.
import layout from '../ui/layout.module.css'

export function PageHead({ title }: { title: string }) {
  return (
    <div className={layout.ph}>
      <div className={layout.t}>
        <h1>{title}</h1>
      </div>
    </div>
  )
}
