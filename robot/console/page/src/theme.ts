// Grey, or dark for a dark room. Kept by the browser.
import { effect, signal } from '@preact/signals'

const kKey = 'dark'

export const dark = signal(localStorage.getItem(kKey) === 'yes')

effect(() => {
  document.documentElement.dataset.theme = dark.value ? 'dark' : 'grey'
  localStorage.setItem(kKey, dark.value ? 'yes' : 'no')
})
