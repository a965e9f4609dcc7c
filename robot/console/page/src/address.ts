// The address of this page: its token goes with every request.
export const token = new URLSearchParams(location.search).get('t') ?? ''
export const withToken = (path: string) => `${path}?t=${token}`
