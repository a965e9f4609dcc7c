// A cable between the browser and the console: it can be cut, or go silent as one does that is pulled out.
import { connect, createServer, type Server, type Socket } from 'node:net'

export class Cable {
  private server: Server
  private pairs: [Socket, Socket][] = []
  private plugged = true

  private constructor(private port: number) {
    this.server = createServer((near) => this.join(near))
  }
  // The address of the page through this cable.
  url = ''
  static async to(url: string): Promise<Cable> {
    const cable = new Cable(Number(new URL(url).port))
    await new Promise<void>((resolve) => cable.server.listen(0, '127.0.0.1', resolve))
    cable.url = url.replace(`:${cable.port}/`, `:${cable.ownPort()}/`)
    return cable
  }
  cut(): void {
    this.plugged = false
    for (const pair of this.pairs.splice(0)) for (const end of pair) end.destroy()
  }
  // Nothing arrives any more, and nobody is told. What was sent arrives when it speaks again.
  goSilent(): void {
    for (const [near, far] of this.pairs) {
      near.unpipe(far)
      far.unpipe(near)
    }
  }
  speakAgain(): void {
    for (const [near, far] of this.pairs) {
      near.pipe(far)
      far.pipe(near)
    }
  }
  plugIn(): void {
    this.plugged = true
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
    if (!this.plugged) return void near.destroy()
    const far = connect(this.port, '127.0.0.1')
    for (const end of [near, far]) end.setNoDelay(true).on('error', () => end.destroy())
    near.once('data', (head) => {
      // The console answers only requests that name it.
      far.write(head.toString('latin1').replaceAll(`127.0.0.1:${this.ownPort()}`, `127.0.0.1:${this.port}`), 'latin1')
      near.pipe(far)
    })
    far.pipe(near)
    this.pairs.push([near, far])
  }
}
