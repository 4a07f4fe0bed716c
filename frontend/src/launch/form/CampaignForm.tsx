// The form of a campaign by sections; rarely used ones are collapsed.
import type { Catalogue } from '../../client'
import { AboutForm } from './AboutForm'
import { CriterionForm } from './CriterionForm'
import { MethodsTable } from './MethodsTable'
import { type Campaign, hasScenario } from '../../api/campaign'
import type { Parameter } from '../campaign/parameters'
import { ProposalCard } from '../proposal/ProposalCard'
import { ScenarioForm } from './ScenarioForm'
import { SettingsForm } from './SettingsForm'
import { ResultForm, SimulatorForm } from './SimulatorForm'
import { UncertainTable } from './UncertainTable'
import { idOf } from '../fields/problems'
import type { Section } from '../../ui/SectionTabs'
import type { Draft } from '../draft/useDraft'

interface CampaignFormProps {
  draft: Draft
  catalogue: Catalogue
  parameters: Parameter[]
}

export function CampaignForm({ draft, catalogue, parameters }: CampaignFormProps) {
  const { campaign, set, remove } = draft
  return (
    <>
      <UncertainTable campaign={campaign} parameters={parameters} set={set} />
      {hasScenario(campaign) ? (
        <CriterionForm campaign={campaign} catalogue={catalogue} set={set} remove={remove} />
      ) : (
        <ResultForm campaign={campaign} catalogue={catalogue} set={set} />
      )}
      {!hasScenario(campaign) && <ProposalCard campaign={campaign} catalogue={catalogue} set={set} />}
      <MethodsTable campaign={campaign} catalogue={catalogue} parameters={parameters} set={set} />
      <SettingsForm campaign={campaign} set={set} />
      {hasScenario(campaign) ? (
        <ScenarioForm campaign={campaign} catalogue={catalogue} set={set} remove={remove} />
      ) : (
        <SimulatorForm campaign={campaign} catalogue={catalogue} parameters={parameters} set={set} />
      )}
      <AboutForm campaign={campaign} set={set} />
    </>
  )
}

/** The sections of the form in their order on the page. */
export const sectionsOf = (campaign: Campaign): Section[] =>
  [
    { id: 'section-uncertain', name: 'Parameters', count: Object.keys(campaign.uncertain).length },
    { id: 'section-criterion', name: 'Criterion' },
    !hasScenario(campaign) && { id: 'section-proposal', name: 'Proposal' },
    { id: 'section-methods', name: 'Methods', count: campaign.stages.search.length },
    { id: 'section-stages', name: 'Certify, verdict' },
    hasScenario(campaign) ? { id: idOf('scenario'), name: 'Scenario' } : { id: idOf('simulator'), name: 'Simulator' },
    { id: 'section-about', name: 'About' },
  ].filter((section) => section !== false)
