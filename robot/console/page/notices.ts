// The licences of everything that the bundler put into the page, as one text beside it: third-party-notices.txt. The build
// fails on a licence that is not in the list, and on a package without its text.
import { existsSync, readdirSync, readFileSync } from 'node:fs'
import type { Plugin } from 'vite'

const permitted = new Set(['MIT', 'ISC', 'BSD-2-Clause', 'BSD-3-Clause', 'Apache-2.0'])
const rule = `\n\n${'-'.repeat(80)}\n\n`

// licences/ has the texts that packages left out.
function textOf(name: string, folder: string): string {
  const inPackage = readdirSync(folder).find((file) => /^licen[cs]e/i.test(file))
  const added = new URL(`./licences/${name.replace('/', '+')}.txt`, import.meta.url)
  if (inPackage) return readFileSync(`${folder}/${inPackage}`, 'utf8').trim()
  if (existsSync(added)) return readFileSync(added, 'utf8').trim()
  throw new Error(`${name} comes without the text of its licence: add ${added.pathname}`)
}

function noticeOf(folder: string): string {
  const { name, version, license } = JSON.parse(readFileSync(`${folder}/package.json`, 'utf8'))
  if (!permitted.has(license)) throw new Error(`${name} ${version}: licence "${license}" is not one that may be shipped`)
  return `${name} ${version} (${license})\n\n${textOf(name, folder)}`
}

export function notices(): Plugin {
  return {
    name: 'notices',
    generateBundle(_, bundle) {
      const folders = new Set<string>()
      for (const output of Object.values(bundle))
        for (const module of output.type === 'chunk' ? Object.keys(output.modules) : []) {
          const folder = /^\0?(.*\/node_modules\/(?:@[^/]+\/)?[^/]+)\//.exec(module)?.[1]
          if (folder) folders.add(folder)
        }
      const source = `${[...folders].sort().map(noticeOf).join(rule)}\n`
      this.emitFile({ type: 'asset', fileName: 'third-party-notices.txt', source })
    },
  }
}
