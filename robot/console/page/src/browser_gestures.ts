// What a browser does by itself, and what would take the page, STOP or the keyboard away from the operator: a menu that
// takes the next click and Esc, a file that is dropped and opened, a drag during which no input arrives, zoom by wheel,
// one page back by the thumb's button of a mouse. Zoom by keys stays. See also touch-action and overscroll-behavior in
// style/base.css.
const kMiddle = 1
const kBack = 3

export function preventGestures(): void {
  const prevent = (event: Event) => event.preventDefault()
  for (const name of ['contextmenu', 'dragstart', 'dragover', 'drop']) window.addEventListener(name, prevent)
  window.addEventListener('wheel', (event) => event.ctrlKey && prevent(event), { passive: false })
  for (const name of ['mousedown', 'mouseup', 'auxclick'] as const)
    window.addEventListener(name, (event) => (event.button >= kBack || (event.button === kMiddle && name === 'mousedown')) && prevent(event))
}
