// Formats units as in print: superscript powers and a dot between factors.

const RAISED: Record<string, string> = { '2': '²', '3': '³', '4': '⁴' }

/** "kg m2" -> "kg·m²", "N s2/m" -> "N·s²/m". */
export function unitText(unit: string): string {
  return unit
    .replace(/([A-Za-zµΩ°])\^?([234])(?!\d)/g, (_, letter: string, power: string) => letter + (RAISED[power] ?? power))
    .replace(/(?<=\S) (?=\S)/g, '·')
}

/** What follows a quantity in a title: ", m", or nothing if it has no unit. */
export const ofUnit = (unit: string): string => unit && `, ${unit}`
