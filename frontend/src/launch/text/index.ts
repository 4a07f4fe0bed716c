// What the launch page needs of a campaign's text, in a file of its own that comes after the page. Start: `amend`.
export { amended } from './amend'
export { changesOf } from './changes'
export { formOf } from './form'
export { takingOut } from './taking'
