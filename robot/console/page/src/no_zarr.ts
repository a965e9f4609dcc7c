// Stands in for a library of the viewer that reads images over the network: this page never does.
const never = () => {
  throw new Error('not part of this page')
}
export const open = never
export const get = never
export const slice = never
export const root = never
export const registry = new Map()
export class FetchStore {}
export default {}
