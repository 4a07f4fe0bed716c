// Whether something typed on this page is not saved. Whoever keeps it asks before the page is left: that is what is asked here.

export const unsaved = (): boolean => !window.dispatchEvent(new Event('beforeunload', { cancelable: true }))
