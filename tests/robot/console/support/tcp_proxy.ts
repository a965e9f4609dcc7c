// A TCP proxy between browser and console that can close its connections, or stall like a pulled cable.
import { connect, createServer, type Server, type Socket } from 'node:net'

export class TcpProxy {
  private server: Server
  private pairs: [Socket, Socket][] = []
  private opened = true

  private constructor(private port: number) {
    this.server = createServer((near) => this.join(near))
  }
  // The address of the page through the proxy.
  url = ''
  static async to(url: string): Promise<TcpProxy> {
    const proxy = new TcpProxy(Number(new URL(url).port))
    await new Promise<void>((resolve) => proxy.server.listen(0, '127.0.0.1', resolve))
    proxy.url = url.replace(`:${proxy.port}/`, `:${proxy.ownPort()}/`)
    return proxy
  }
  cut(): void {
    this.opened = false
    for (const pair of this.pairs.splice(0)) for (const end of pair) end.destroy()
  }
  // No data pass, and the connections stay open. What was sent arrives after resume().
  stall(): void {
    for (const [near, far] of this.pairs) {
      near.unpipe(far)
      far.unpipe(near)
    }
  }
  resume(): void {
    for (const [near, far] of this.pairs) {
      near.pipe(far)
      far.pipe(near)
    }
  }
  reopen(): void {
    this.opened = true
  }
  async remove(): Promise<void> {
    this.cut()
    await new Promise((resolve) => this.server.close(resolve))
  }

  private ownPort(): number {
    const address = this.server.address()
    return typeof address === 'object' && address ? address.port : 0
  }
  private join(near: Socket): void {
    if (!this.opened) return void near.destroy()
    const far = connect(this.port, '127.0.0.1')
    for (const end of [near, far]) end.setNoDelay(true).on('error', () => end.destroy())
    near.once('data', (head) => {
      // The console accepts only requests that name it.
      far.write(head.toString('latin1').replaceAll(`127.0.0.1:${this.ownPort()}`, `127.0.0.1:${this.port}`), 'latin1')
      near.pipe(far)
    })
    far.pipe(near)
    this.pairs.push([near, far])
  }
}
