// Angles as drawings take them. A file of its own: what several pages draw must not bring the charts along.
export const degrees = (angle: number): number => (angle * 180) / Math.PI
