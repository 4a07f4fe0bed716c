// The form of a campaign by sections, with the tabs above it; rarely used ones are collapsed.
import { memo } from 'react'
import { AboutForm } from './AboutForm'
import { CriterionForm } from './CriterionForm'
import { MethodsTable } from './MethodsTable'
import { type Campaign, hasScenario } from '../../api/campaign'
import type { Section } from '../../ui/SectionTabs'
import { idOf } from '../fields/problems'
import type { FormProps } from '../fields/props'
import { ProposalCard } from '../proposal/ProposalCard'
import { ScenarioForm } from './ScenarioForm'
import { SettingsForm } from './SettingsForm'
import { ResultForm, SimulatorForm } from './SimulatorForm'
import { UncertainTable } from './UncertainTable'

/** Rendered again only if the campaign changes, not while its text is checked. */
export const CampaignForm = memo(function CampaignForm(form: FormProps) {
  const flies = hasScenario(form.campaign)
  return (
    <>
      <UncertainTable {...form} />
      {flies ? <CriterionForm {...form} /> : <ResultForm {...form} />}
      {!flies && <ProposalCard {...form} />}
      <MethodsTable {...form} />
      <SettingsForm {...form} />
      {flies ? <ScenarioForm {...form} /> : <SimulatorForm {...form} />}
      <AboutForm {...form} />
    </>
  )
})

/** The sections in their order on the page. */
export const tabsOf = (campaign: Campaign): Section[] => [
  { id: 'section-uncertain', name: 'Parameters', count: Object.keys(campaign.uncertain).length },
  { id: 'section-criterion', name: 'Criterion' },
  ...(hasScenario(campaign) ? [] : [{ id: 'section-proposal', name: 'Proposal' }]),
  { id: 'section-methods', name: 'Methods', count: campaign.stages.search.length },
  { id: 'section-stages', name: 'Certify, verdict' },
  hasScenario(campaign) ? { id: idOf('scenario'), name: 'Scenario' } : { id: idOf('simulator'), name: 'Simulator' },
  { id: 'section-about', name: 'About' },
]
