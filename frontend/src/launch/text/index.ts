// Text editing for the launch page, as a separate bundle that is loaded after the page.
export { amended } from './amend'
export { changesOf } from './changes'
export { formOf } from './form'
export { takingOut } from './taking'
